// Rows of a machine's file (bench/machines/README.md): how every benchmark writes what it measured.
#pragma once

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "brunt.h"
#include "base/simd.h"
#include "base/parallel.h"

#ifndef BRUNT_BENCH_FLAGS
#define BRUNT_BENCH_FLAGS "unknown"
#endif

static inline int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Sorts the samples.
static inline double median_of(double *samples, int count) {
    qsort(samples, (size_t)count, sizeof *samples, ascending);
    return 0.5 * (samples[(count - 1) / 2] + samples[count / 2]);
}

// The first line of a file that begins with `key`, behind the key and colon; "unknown" when there is none.
static inline void first_line(const char *path, const char *key, char *out, size_t size) {
    char line[256];
    snprintf(out, size, "unknown");
    FILE *in = fopen(path, "r");
    while (in && fgets(line, sizeof line, in)) {
        if (strncmp(line, key, strlen(key)) != 0) continue;
        const char *colon = *key ? strchr(line, ':') : NULL, *value = colon ? colon + 1 : line;
        value += strspn(value, " \t");
        snprintf(out, size, "%.*s", (int)strcspn(value, "\n"), value);
        break;
    }
    if (in) fclose(in);
}

static inline void write_caches(FILE *out) {
    fprintf(out, "# caches:");
    for (int k = 0; k < 8; k++) {
        char path[96], level[16], kind[32], size[32];
        snprintf(path, sizeof path, "/sys/devices/system/cpu/cpu0/cache/index%d/level", k);
        if (access(path, R_OK) != 0) break;
        first_line(path, "", level, sizeof level);
        snprintf(path, sizeof path, "/sys/devices/system/cpu/cpu0/cache/index%d/type", k);
        first_line(path, "", kind, sizeof kind);
        snprintf(path, sizeof path, "/sys/devices/system/cpu/cpu0/cache/index%d/size", k);
        first_line(path, "", size, sizeof size);
        fprintf(out, "%s L%s %s %s", k ? "," : "", level, kind, size);
    }
    fprintf(out, "\n");
}

// What it is measured on, and the names of the columns.
static inline void write_heading(FILE *out) {
    char processor[128], date[32];
    first_line("/proc/cpuinfo", "model name", processor, sizeof processor);
#ifdef __clang__
    const char *compiler = __VERSION__;
#else
    const char *compiler = "gcc " __VERSION__;
#endif
    const time_t now = time(NULL);
    strftime(date, sizeof date, "%Y-%m-%d", gmtime(&now));
    fprintf(out, "# processor: %s\n# cores: %ld\n", processor, sysconf(_SC_NPROCESSORS_ONLN));
    write_caches(out);
    fprintf(out, "# memory: %.1f GB\n", 1e-9 * (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE));
    fprintf(out, "# compiler: %s\n# flags: %s\n", compiler, BRUNT_BENCH_FLAGS);
    fprintf(out, "# precision: %s\n# lanes: %d\n# version: %s\n# date: %s\n", BRUNT_REAL_NAME, BRUNT_LANES,
            BRUNT_VERSION, date);
    fprintf(out, "kind,name,units,threads,figure,unit,median,least,rounds\n");
}

// To be appended to, so that benchmarks one after the other write one file; the heading when it is new. NULL, and said
// why, when it cannot be.
static inline FILE *open_rows(const char *path) {
    FILE *out = fopen(path, "a");
    if (!out) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return NULL;
    }
    if (fseek(out, 0, SEEK_END) == 0 && ftell(out) == 0) write_heading(out);
    return out;
}

// false when what was written is not all there. `out` may be NULL.
static inline bool close_rows(FILE *out) {
    if (!out) return true;
    const bool failed = ferror(out);
    return fclose(out) == 0 && !failed;
}

typedef struct row_key {
    const char *kind, *name;
    double units;
    int threads;
} row_key;

static inline void write_row(FILE *out, row_key key, const char *figure, const char *unit, double median, double least,
                             int rounds) {
    if (out)
        fprintf(out, "%s,%s,%.0f,%d,%s,%s,%.6g,%.6g,%d\n", key.kind, key.name, key.units, key.threads, figure, unit,
                median, least, rounds);
}

// Median and least of the samples, which are sorted. Returns the median.
static inline double write_samples(FILE *out, row_key key, const char *figure, const char *unit, double *samples,
                                   int rounds) {
    const double median = median_of(samples, rounds);
    write_row(out, key, figure, unit, median, samples[0], rounds);
    return median;
}

// A list of whole numbers from 1 to `most`, 0 when it is none.
static inline int read_list(const char *text, int64_t most, int limit, int64_t *out) {
    for (int count = 0;;) {
        char *end;
        const long long value = strtoll(text, &end, 10);
        if (end == text || value < 1 || value > most || count == limit) return 0;
        out[count++] = value;
        if (!*end) return count;
        if (*end != ',') return 0;
        text = end + 1;
    }
}

// As the program does (engine/app/cmd_run.c): libgomp reads it when it is loaded, hence the second start. Where other
// work wants the processors too, its own choice made each pass last 8 ms.
static inline void start_with_short_spins(char **argv) {
    if (getenv("GOMP_SPINCOUNT") || getenv("OMP_WAIT_POLICY")) return;
    if (setenv("GOMP_SPINCOUNT", "10000", 1) == 0) execv("/proc/self/exe", argv);
}
