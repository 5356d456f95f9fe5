"""The part of a linker that PoCL needs: one x86-64 object becomes a shared library.

PoCL, the OpenCL of machines without a GPU, runs ``ld`` on every kernel it compiles, and asks for
the C library's development files, though its objects use neither: their built-in functions are
compiled in. This stands in for ``ld`` where there is no compiler (see ``linker.py``)::

    one object                     the library: addresses are file offsets
    .text .rodata .eh_frame ...    | header | names, hash, fixes | read-only sections, stubs |
    .data .bss ...                 | offset table, .dynamic, writable sections               |

A call of a function that the object lacks (``memset``) jumps through a stub and the offset table,
which the loader fills, as ``ld`` does it. Layouts and relocations: System V ABI (gABI 4.1,
chapters 4 and 5) and its AMD64 supplement (table 4.9). A program of the standard library alone, so
that it starts in 20 ms: ``python elf.py ... -o library.so object.o ...``; other options are
ld's and mean nothing here.
"""

from __future__ import annotations

import struct
import sys
from dataclasses import dataclass
from pathlib import Path

PAGE = 4096
HEADER = struct.Struct("<16s2HI3QI6H")
PROGRAM = struct.Struct("<2I6Q")
SECTION = struct.Struct("<2I4Q2I2Q")
SYMBOL = struct.Struct("<I2BH2Q")
FIX = struct.Struct("<2Qq")
DYNAMIC = struct.Struct("<2Q")
ALLOCATED, WRITABLE, THREAD_LOCAL = 0x2, 0x1, 0x400  # section flags
SYMBOL_TABLE, ADDENDS, NO_BITS = 2, 4, 8  # section types
RELATIVE = 8  # the loader adds where it put the library
# relocation types by what they store: S symbol, A addend, P place, G slot of the offset table
ABSOLUTE_64, RELATIVE_64 = 1, 24  # S + A, S + A - P
RELATIVE_32 = (2, 4)  # S + A - P
TABLE_32 = (9, 41, 42)  # G + A - P


@dataclass(eq=False)
class Section:
    """A piece of the object that takes memory, and where it goes."""

    content: bytes
    alignment: int
    writable: bool
    address: int = 0


@dataclass(eq=False)
class Symbol:
    """A name of the object: in `section`, or to be found by the loader where that is None."""

    name: bytes
    section: Section | None
    value: int
    size: int
    info: int
    exported: bool

    @property
    def address(self) -> int:
        return self.section.address + self.value if self.section else 0


@dataclass(eq=False)
class Relocation:
    """Four or eight bytes of `section` that depend on an address."""

    section: Section
    offset: int
    kind: int
    symbol: Symbol
    addend: int

    @property
    def address(self) -> int:
        return self.section.address + self.offset


class LinkError(Exception):
    """The object needs more of a linker than this one is."""


def read_object(data: bytes) -> tuple[list[Section], list[Symbol], list[Relocation]]:
    """Return what an object file holds."""
    header = HEADER.unpack_from(data)
    if header[0][:6] != b"\x7fELF\x02\x01" or header[1:3] != (1, 62):
        raise LinkError("expected one 64-bit x86 object file")
    start, count = header[6], header[12]
    rows = [SECTION.unpack_from(data, start + i * SECTION.size) for i in range(count)]
    sections: dict[int, Section] = {}
    for index, (_, kind, flags, _, offset, size, _, _, alignment, _) in enumerate(rows):
        if flags & THREAD_LOCAL:
            raise LinkError("expected no thread-local data")
        if flags & ALLOCATED:
            content = bytes(size) if kind == NO_BITS else data[offset : offset + size]
            sections[index] = Section(content, max(alignment, 1), bool(flags & WRITABLE))
    table = next((row for row in rows if row[1] == SYMBOL_TABLE), None)
    if table is None:
        raise LinkError("expected a symbol table")
    names = rows[table[6]][4]
    symbols = [
        _symbol(data, names, sections, SYMBOL.unpack_from(data, table[4] + at))
        for at in range(0, table[5], SYMBOL.size)
    ]
    relocations = [
        Relocation(sections[row[7]], place, info & 0xFFFFFFFF, symbols[info >> 32], addend)
        for row in rows
        if row[1] == ADDENDS and row[7] in sections
        for place, info, addend in FIX.iter_unpack(data[row[4] : row[4] + row[5]])
    ]
    return list(sections.values()), symbols, relocations


def _symbol(
    data: bytes, names: int, sections: dict[int, Section], fields: tuple[int, ...]
) -> Symbol:
    name, info, other, index, value, size = fields
    text = data[names + name : data.index(b"\0", names + name)]
    is_global, is_hidden = info >> 4 != 0, other & 3 in (1, 2)
    if index and index not in sections and is_global:
        raise LinkError(f"expected {text.decode()} in a section, got section {index}")
    return Symbol(
        text, sections.get(index), value, size, info, is_global and bool(index) and not is_hidden
    )


class Library:
    """A shared library of an object's sections; `image` grows into its bytes."""

    def __init__(
        self, sections: list[Section], symbols: list[Symbol], relocations: list[Relocation]
    ) -> None:
        self.image = bytearray()
        self.sections, self.relocations = sections, relocations
        self.words = [fix for fix in relocations if fix.kind == ABSOLUTE_64]
        # what has a slot of the offset table: its own references, and calls out of the object
        far = [
            fix.symbol
            for fix in relocations
            if fix.kind in TABLE_32 or (fix.kind in RELATIVE_32 and fix.symbol.section is None)
        ]
        self.slots = {symbol: slot for slot, symbol in enumerate(dict.fromkeys(far))}
        wanted = dict.fromkeys([*far, *(fix.symbol for fix in self.words)])
        self.named = [symbol for symbol in wanted if symbol.section is None]
        self.named += [symbol for symbol in symbols if symbol.exported]
        self.texts = b"\0" + b"".join(symbol.name + b"\0" for symbol in self.named)
        self._lay_out()

    def _place(self, size: int, alignment: int = 8) -> int:
        """Return the address of `size` bytes more."""
        self.image.extend(bytes(-len(self.image) % alignment))
        address = len(self.image)
        self.image.extend(bytes(size))
        return address

    def _lay_out(self) -> None:
        """Give everything its address, in the order of the drawing above."""
        self._place(HEADER.size + 4 * PROGRAM.size)
        self.names_at = self._place(SYMBOL.size * (1 + len(self.named)))
        self.texts_at = self._place(len(self.texts))
        self.hash_at = self._place(4 * (4 + len(self.named)))
        self.fixes_at = self._place(FIX.size * (len(self.slots) + len(self.words)))
        for section in self.sections:
            if not section.writable:
                section.address = self._place(len(section.content), section.alignment)
        self.stubs_at = self._place(8 * len(self.slots))
        self.split = self._place(0, PAGE)
        self.table_at = self._place(8 * len(self.slots))
        self.dynamic_at = self._place(DYNAMIC.size * 9)
        for section in self.sections:
            if section.writable:
                section.address = self._place(len(section.content), section.alignment)

    def write(self, address: int, content: bytes) -> None:
        self.image[address : address + len(content)] = content

    def write_names(self) -> None:
        """The dynamic symbols, their texts, and a hash table of one bucket that chains them all."""
        text = 1
        for number, symbol in enumerate(self.named, start=1):
            place = (1, symbol.address, symbol.size) if symbol.section else (0, 0, 0)
            row = SYMBOL.pack(text, symbol.info, 0, *place)
            self.write(self.names_at + SYMBOL.size * number, row)
            text += len(symbol.name) + 1
        self.write(self.texts_at, self.texts)
        count = len(self.named)
        follower = [*range(2, count + 1), 0][:count]  # 1 leads to 2, 2 to 3, the last to none
        table = (1, 1 + count, min(1, count), 0, *follower)
        self.write(self.hash_at, struct.pack(f"<{4 + count}I", *table))

    def write_fixes(self) -> None:
        """What the loader fills in, and the stubs that jump through the offset table."""
        places = [(self.table_at + 8 * slot, symbol, 0) for symbol, slot in self.slots.items()]
        places += [(fix.address, fix.symbol, fix.addend) for fix in self.words]
        numbers = {symbol: number for number, symbol in enumerate(self.named, start=1)}
        for index, (place, symbol, addend) in enumerate(places):
            row = FIX.pack(place, RELATIVE, symbol.address + addend)
            if symbol.section is None:
                row = FIX.pack(place, numbers[symbol] << 32 | ABSOLUTE_64, addend)
            self.write(self.fixes_at + FIX.size * index, row)
        for slot in self.slots.values():
            stub = self.stubs_at + 8 * slot
            jump = struct.pack("<2si", b"\xff\x25", self.table_at + 8 * slot - (stub + 6))
            self.write(stub, jump)  # jmp *slot(%rip)

    def relocate(self, fix: Relocation) -> None:
        """Store the address that `fix` asks for."""
        symbol, slot = fix.symbol, 8 * self.slots.get(fix.symbol, 0)
        near = symbol.address if symbol.section else self.stubs_at + slot
        if fix.kind in RELATIVE_32:
            self.write(fix.address, struct.pack("<i", near + fix.addend - fix.address))
        elif fix.kind in TABLE_32:
            target = self.table_at + slot
            self.write(fix.address, struct.pack("<i", target + fix.addend - fix.address))
        elif fix.kind == RELATIVE_64 and symbol.section:
            self.write(fix.address, struct.pack("<q", near + fix.addend - fix.address))
        elif fix.kind != ABSOLUTE_64:
            raise LinkError(f"expected no relocation of type {fix.kind}")

    def write_headers(self) -> None:
        """The two segments, where the loader finds its tables, and the file's own header."""
        end, dynamic_size = len(self.image), DYNAMIC.size * 9
        fixes_size = FIX.size * (len(self.slots) + len(self.words))
        entries = [
            (4, self.hash_at),
            (5, self.texts_at),
            (6, self.names_at),
            (7, self.fixes_at),
            (8, fixes_size),
            (9, FIX.size),
            (10, len(self.texts)),
            (11, SYMBOL.size),
            (0, 0),
        ]
        self.write(self.dynamic_at, b"".join(DYNAMIC.pack(*entry) for entry in entries))
        programs = (
            (1, 5, 0, 0, 0, self.split, self.split, PAGE),  # load, read and execute
            (1, 6, *[self.split] * 3, *[end - self.split] * 2, PAGE),  # load, read and write
            (2, 6, *[self.dynamic_at] * 3, *[dynamic_size] * 2, 8),  # dynamic
            (0x6474E551, 6, 0, 0, 0, 0, 0, 16),  # a stack that nothing executes
        )
        magic = b"\x7fELF\x02\x01\x01"
        shape = (HEADER.size, PROGRAM.size, len(programs), SECTION.size, 0, 0)
        self.write(0, HEADER.pack(magic, 3, 62, 1, 0, HEADER.size, 0, 0, *shape))
        self.write(HEADER.size, b"".join(PROGRAM.pack(*program) for program in programs))


def link(data: bytes) -> bytes:
    """Return the shared library of one object file."""
    sections, symbols, relocations = read_object(data)
    library = Library(sections, symbols, relocations)
    for section in sections:
        library.write(section.address, section.content)
    library.write_names()
    library.write_fixes()
    for fix in relocations:
        library.relocate(fix)
    library.write_headers()
    return bytes(library.image)


def main(arguments: list[str]) -> int:
    """Link as ``ld ... -o library.so object.o ...`` would."""
    if "--version" in arguments:
        print(__doc__.partition("\n")[0])
        return 0
    objects = [argument for argument in arguments if argument.endswith(".o")]
    try:
        if len(objects) != 1 or "-o" not in arguments:
            raise LinkError(f"expected one object and -o, got {' '.join(arguments)}")
        library = link(Path(objects[0]).read_bytes())
        Path(arguments[arguments.index("-o") + 1]).write_bytes(library)
    except (LinkError, OSError) as error:
        print(f"terrain_lod's linker: {error}: install gcc for its ld", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
