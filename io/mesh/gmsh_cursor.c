#include "io/mesh/gmsh_cursor.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brunt.h"
#include "base/error.h"

void gmsh_complain(gmsh_cursor *c, const char *at, const char *format, ...) {
    if (c->status) return;
    char what[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    const char *start = c->file->bytes;
    if (c->file->binary) {
        c->status =
            brunt_fail(c->error, BRUNT_BAD_INPUT, "%s, byte %lld: %s", c->file->path, (long long)(at - start), what);
        return;
    }
    long long line = 1;
    for (const char *p = start; p < at; p++) line += *p == '\n';
    c->status = brunt_fail(c->error, BRUNT_BAD_INPUT, "%s:%lld: %s", c->file->path, line, what);
}

void gmsh_out_of_memory(gmsh_cursor *c) {
    if (!c->status) c->status = brunt_fail(c->error, BRUNT_FAILED, "%s: no memory for this mesh", c->file->path);
}

static bool blank(char letter) { return letter == ' ' || letter == '\t' || letter == '\r'; }

void gmsh_skip_blank(gmsh_cursor *c) {
    while (c->at < c->end && (blank(*c->at) || *c->at == '\n')) c->at++;
}

static void skip_in_line(gmsh_cursor *c) {
    while (c->at < c->end && blank(*c->at)) c->at++;
}

gmsh_word gmsh_next_word(gmsh_cursor *c) {
    skip_in_line(c);
    gmsh_word word = {.at = c->at};
    while (c->at < c->end && !blank(*c->at) && *c->at != '\n') c->at++;
    word.length = (int)(c->at - word.at < 200 ? c->at - word.at : 200);
    return word;
}

// Says what stands where a number was wanted, and stays there.
static void complain_number(gmsh_cursor *c, const char *at, const char *what) {
    if (c->binary) {
        gmsh_complain(c, at, "a number out of range where %s is wanted", what);
        return;
    }
    c->at = at;
    gmsh_word word = gmsh_next_word(c);
    c->at = at;
    if (word.at >= c->end)
        gmsh_complain(c, at, "the file ends in %s, where %s is wanted", c->section, what);
    else if (word.length == 0)
        gmsh_complain(c, at, "the line ends where %s is wanted", what);
    else
        gmsh_complain(c, at, "'%.*s' is not %s", word.length < 40 ? word.length : 40, word.at, what);
}

static const char *take_bytes(gmsh_cursor *c, size_t bytes, const char *what) {
    if (c->status) return NULL;
    if ((size_t)(c->end - c->at) < bytes) {
        gmsh_complain(c, c->at, "the file ends in %s, where %s is wanted", c->section, what);
        return NULL;
    }
    c->at += bytes;
    return c->at - bytes;
}

static int64_t text_integer(gmsh_cursor *c, const char *what) {
    skip_in_line(c);
    const char *at = c->at, *p = at;
    bool negative = p < c->end && *p == '-';
    uint64_t value = 0;
    int digits = 0;
    if (p < c->end && (*p == '-' || *p == '+')) p++;
    for (; p < c->end && *p >= '0' && *p <= '9' && digits < 19; p++, digits++)
        value = 10 * value + (uint64_t)(*p - '0');
    bool ends = p == c->end || blank(*p) || *p == '\n';
    if (!digits || !ends || value > INT64_MAX) {
        complain_number(c, at, what);
        return 0;
    }
    c->at = p;
    return negative ? -(int64_t)value : (int64_t)value;
}

int64_t gmsh_integer(gmsh_cursor *c, int bytes, const char *what) {
    if (c->status) return 0;
    if (!c->binary) return text_integer(c, what);
    const char *from = take_bytes(c, (size_t)bytes, what);
    if (!from) return 0;
    int32_t narrow;
    int64_t wide;
    memcpy(bytes == 4 ? (void *)&narrow : (void *)&wide, from, (size_t)bytes);
    return bytes == 4 ? narrow : wide;
}

int32_t gmsh_tag(gmsh_cursor *c, const char *what) {
    const char *at = c->at;
    int64_t value = gmsh_integer(c, 4, what);
    if (value < -INT32_MAX || value > INT32_MAX) complain_number(c, at, what);
    return c->status ? 0 : (int32_t)value;
}

double gmsh_real(gmsh_cursor *c, const char *what) {
    if (c->status) return 0;
    double value = 0;
    if (!c->binary) skip_in_line(c);
    const char *at = c->at;
    if (c->binary) {
        const char *from = take_bytes(c, sizeof value, what);
        if (!from) return 0;
        memcpy(&value, from, sizeof value);
        if (!isfinite(value)) gmsh_complain(c, at, "%s is not a finite number", what);
    } else {
        char *end = NULL;
        if (at < c->end && *at != '\n') value = strtod(at, &end); // would run over the ends of lines
        bool ends = end && end > at && (end == c->end || blank(*end) || *end == '\n');
        if (!ends || !isfinite(value)) {
            complain_number(c, at, what);
            return 0;
        }
        c->at = end;
    }
    if (fabs(value) > BRUNT_GREATEST_NUMBER)
        gmsh_complain(c, at, "%s is %g, at most %g is wanted", what, value, BRUNT_GREATEST_NUMBER);
    return c->status ? 0 : value;
}

int64_t gmsh_count(gmsh_cursor *c, int bytes, size_t least_text, size_t least_binary, const char *what) {
    if (!c->binary) skip_in_line(c);
    const char *at = c->at;
    int64_t count = gmsh_integer(c, bytes, what);
    if (c->status) return 0;
    size_t left = (size_t)(c->end - c->at), least = c->binary ? least_binary : least_text;
    if (count < 0)
        gmsh_complain(c, at, "%s is %lld", what, (long long)count);
    else if (count > INT32_MAX || (uint64_t)count > left / least)
        gmsh_complain(c, at, "%s is %lld, but only %zu bytes of the file follow", what, (long long)count, left);
    return c->status ? 0 : count;
}

void gmsh_end_line(gmsh_cursor *c) {
    if (c->binary || c->status) return;
    gmsh_word word = gmsh_next_word(c);
    if (word.length)
        gmsh_complain(c, word.at, "'%.*s' at the end of a line of %s: nothing more is wanted there",
                      word.length < 40 ? word.length : 40, word.at, c->section);
}

void gmsh_begin_line(gmsh_cursor *c) {
    if (!c->binary) gmsh_skip_blank(c);
}
