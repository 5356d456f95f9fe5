// How far a pattern is from a lattice, by one item that takes eight samples of a row at a time.
//
// All rows of samples between two lines of vertices lie on the same triangles: what is known of these is
// laid out column by column once, and a row is then straight sums.
//
//     z = start + slope_x x + slope_y y     on the first of a cell's two triangles: x = a, y = b;
//                                           on the second, where the diagonal rises: 1 - a, 1 - b
#ifndef LATTICE_ROWS_H
#define LATTICE_ROWS_H

typedef struct {
    float start[PITCH], slope_x[PITCH], slope_y[PITCH];
} Plane;

// a line of samples as a pattern of f segments has it
typedef struct {
    int cell[PITCH];
    float fraction[PITCH];
} Columns;

inline void lay_columns(const Lattice *lattice, int f, int count, Columns *columns)
{
    int cell = 0, on = 0;
    for (int k = 0; k < count; ++k, on += lattice->stride * f) {
        for (; on >= lattice->cells_across && cell < f - 1; ++cell)
            on -= lattice->cells_across;
        columns->cell[k] = cell;
        columns->fraction[k] = on;
    }
    for (int k = 0; k < count; ++k)
        columns->fraction[k] /= lattice->cells_across;
}

inline void lay_vertices(const Lattice *lattice, int fu, int fv, int line, float *heights)
{
    const Place down = vertex_place(line, fv, lattice->cells_down, lattice->stride);
    for (int i = 0; i <= fu; ++i)
        heights[i] = vertex_height(lattice, vertex_place(i, fu, lattice->cells_across, lattice->stride),
                                   down);
}

inline float largest_error(const Lattice *lattice, int fu, int fv, Asked columns, Asked rows,
                           float enough, int2 *worst)
{
    float upper[TILE + 1], lower[TILE + 1];
    Columns across;
    Plane first, second;
    int falls[PITCH], asked[PITCH];
    float errors[PITCH];
    const int vectors = columns.last / 8 + 1, count = 8 * vectors;
    lay_columns(lattice, fu, count, &across);
    for (int k = 0; k < count; ++k) {
        asked[k] = k >= columns.first && k <= columns.last ? -1 : 0;
        errors[k] = 0.0f;
    }
    int line = -1;
    for (int row = rows.first; row <= rows.last; ++row) {
        const Place down = pattern_place(row, fv, lattice->cells_down, lattice->stride);
        if (down.line != line) {
            for (int i = 0; i <= fu && down.line == line + 1; ++i)
                upper[i] = lower[i];
            if (line < 0 || down.line != line + 1)
                lay_vertices(lattice, fu, fv, down.line, upper);
            line = down.line;
            lay_vertices(lattice, fu, fv, line + 1, lower);
            for (int k = 0; k < count; ++k) {
                const int i = across.cell[k];
                const float z00 = upper[i], z10 = upper[i + 1], z01 = lower[i], z11 = lower[i + 1];
                const bool falling = is_falling(i, line, fu, fv);
                falls[k] = falling ? -1 : 0;
                first.start[k] = z00;
                first.slope_x[k] = z10 - z00;
                first.slope_y[k] = falling ? z11 - z10 : z01 - z00;
                second.start[k] = falling ? z00 : z11;
                second.slope_x[k] = falling ? z11 - z01 : z01 - z11;
                second.slope_y[k] = falling ? z01 - z00 : z10 - z11;
            }
        }
        const float8 b = down.fraction;
        int8 over = 0;
        for (int v = 0; v < vectors; ++v) {
            const float8 a = vload8(v, across.fraction);
            const int8 falling = vload8(v, falls);
            const int8 is_first = select(a + b <= 1.0f, a >= b, falling);
            const int8 mirrored = ~(falling | is_first);
            const float8 start = select(vload8(v, second.start), vload8(v, first.start), is_first);
            const float8 slope_x = select(vload8(v, second.slope_x), vload8(v, first.slope_x), is_first);
            const float8 slope_y = select(vload8(v, second.slope_y), vload8(v, first.slope_y), is_first);
            const float8 x = select(a, 1.0f - a, mirrored), y = select(b, 1.0f - b, mirrored);
            const float8 off = start + slope_x * x + slope_y * y
                             - vload8(v, lattice->heights + row * PITCH);
            const float8 distance = select((float8)0.0f, select(off, -off, off < 0.0f),
                                           vload8(v, asked));
            const float8 before = vload8(v, errors);
            vstore8(select(before, distance, distance > before), v, errors);
            over |= distance > enough;
        }
        if (any(over)) {
            // what is greatest here will be far off at other factors too
            float error = 0.0f;
            for (int column = columns.first; column <= columns.last; ++column)
                if (errors[column] > error) {
                    error = errors[column];
                    *worst = (int2)(column, row);
                }
            return error;
        }
    }
    float error = 0.0f;
    for (int column = 0; column < count; ++column)
        error = larger(errors[column], error);
    return error;
}

#endif
