#include "base/saved.h"

#include <string.h>

int64_t brunt_saved_count(const brunt_saved *table, int rows) {
    int64_t count = 0;
    for (int r = 0; r < rows; r++) count += (int64_t)table[r].count;
    return count;
}

double *brunt_saved_get(const brunt_saved *table, int rows, const void *from, double *out) {
    for (int r = 0; r < rows; r++) {
        const char *at = (const char *)from + table[r].offset;
        for (size_t c = 0; c < table[r].count; c++) {
            int64_t whole;
            memcpy(&whole, at + 8 * c, sizeof whole);
            if (table[r].whole)
                *out = (double)whole;
            else
                memcpy(out, at + 8 * c, sizeof *out);
            out++;
        }
    }
    return out;
}

const double *brunt_saved_set(const brunt_saved *table, int rows, void *to, const double *in) {
    for (int r = 0; r < rows; r++) {
        char *at = (char *)to + table[r].offset;
        for (size_t c = 0; c < table[r].count; c++, in++) {
            const int64_t whole = table[r].whole ? (int64_t)*in : 0;
            memcpy(at + 8 * c, table[r].whole ? (const void *)&whole : (const void *)in, 8);
        }
    }
    return in;
}
