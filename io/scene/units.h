// Units of a scene's values: conversion to SI with udunits2, and words for what went wrong.
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct brunt_units brunt_units;

enum { BRUNT_UNIT_LENGTH = 48 }; // longest unit that is looked at, with its ending zero

// The units database is read when the first unit is met that is neither the wanted one nor one of the usual. NULL: out
// of memory.
brunt_units *brunt_units_open(void);
void brunt_units_close(brunt_units *units);

// Converts `*value` from `unit` to `wanted` (SI). On failure leaves it and writes why, as "'GPa' is a pressure, a
// velocity (m/s) is wanted". Radians count: a plain ratio is no angle, and a frequency is no angular velocity.
bool brunt_units_convert(brunt_units *units, const char *unit, const char *wanted, double *value, char *message,
                         size_t size);

// SI base units as scenes have them: "N" for "m.kg.s-2"; as they are where there is no such name.
const char *brunt_units_written(const char *base);

// Converts `*value` to the SI base units of its own dimension, and writes those to `base` ("m.s-1"; "1" for a pure
// number).
bool brunt_units_to_si(brunt_units *units, const char *unit, double *value, char base[BRUNT_UNIT_LENGTH], char *message,
                       size_t size);

// "a pressure (Pa)", or just the unit when the quantity has no common name.
void brunt_units_describe(brunt_units *units, const char *unit, char *out, size_t size);

// Reads a whole number literal at the start of `text` (decimal, optional exponent) and sets `*rest` behind it. Returns
// NULL, or what is wrong with it in a few words. Infinities, NaN and numbers a double cannot hold are refused.
const char *brunt_read_number(const char *text, double *value, const char **rest);
// Says in `why` that a number in SI units cannot be computed with ("too large a number, at most 1e+30 is wanted in SI
// units"); `positive`: where it must be above 0. True when it can be.
bool brunt_usable_number(double value, bool positive, char *why, size_t size);
// Shortest decimal form that reads back to the same double.
void brunt_format_number(double value, char out[32]);
