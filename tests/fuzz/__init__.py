"""Inputs that nobody wrote: whatever comes in, the outcome is good or a documented error.

::

    python -m tests.fuzz --seed 1 --inputs 10000      the long run; prints a table
    pytest tests/fuzz                                 the short one

A kind of input is a module with a trial: a function of dice and a folder, which makes one input and
feeds it in. It returns where the result is good, raises the errors that ``terrain_lod.errors``
documents, and `Wrong` where a result is not what it should be. All else is wrong, too: any other
exception, a process that dies or finds no end, memory beyond all measure, words on stderr. Trials
run in child processes. A new kind is a module, and its row in ``kinds.py``.
"""
