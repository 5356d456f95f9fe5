// The same arithmetic on LANES things side by side: what makes a CPU's vector unit busy. A GPU's work-
// items are its lanes; there LANES is 1.
//
// Library functions are calls on a CPU, so there are none: LARGER, SMALLER and ABSOLUTE are choices,
// and a comparison with NaN chooses the second.
#ifndef LANES_H
#define LANES_H

#if LANES == 8
typedef float8 Real;
typedef int8 Whole;
#define SET_LANE(real, lane, value) ((float *)&(real))[lane] = (value)
#define LANE(real, lane) ((const float *)&(real))[lane]
#define WHOLE_LANE(whole, lane) ((const int *)&(whole))[lane]
#define REAL_OF(whole) convert_float8(whole)
#define ANY(choice) any(choice)
#else
typedef float Real;
typedef int Whole;
#define SET_LANE(real, lane, value) (real) = (value)
#define LANE(real, lane) (real)
#define WHOLE_LANE(whole, lane) (whole)
#define REAL_OF(whole) ((float)(whole))
#define ANY(choice) ((choice) != 0)
#endif

#define LARGER(a, b) ((a) > (b) ? (a) : (b))
#define SMALLER(a, b) ((a) < (b) ? (a) : (b))
#define ABSOLUTE(a) ((a) < 0.0f ? -(a) : (a))

#endif
