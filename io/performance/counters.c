// Each kind has a file of its own: the kernel does not let a group of counters be inherited by threads and read at
// once.
#include "io/performance/counters.h"

#include <string.h>

#ifdef __linux__
#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/array.h"

static const uint64_t events[] = {PERF_COUNT_HW_CPU_CYCLES, PERF_COUNT_HW_INSTRUCTIONS, PERF_COUNT_HW_CACHE_MISSES,
                                  PERF_COUNT_HW_BRANCH_MISSES};
_Static_assert(BRUNT_COUNT(events) == BRUNT_COUNTERS, "an event for each counter");

static int open_event(uint64_t event) {
    struct perf_event_attr attributes = {.type = PERF_TYPE_HARDWARE,
                                         .size = sizeof attributes,
                                         .config = event,
                                         .inherit = 1,
                                         .exclude_kernel = 1,
                                         .exclude_hv = 1};
    return (int)syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC);
}

static uint64_t read_event(int file) {
    uint64_t value = 0;
    return file >= 0 && read(file, &value, sizeof value) == (ssize_t)sizeof value ? value : 0;
}

static void close_event(int file) {
    if (file >= 0) close(file);
}
#else
static const uint64_t events[BRUNT_COUNTERS];
static int open_event(uint64_t event) { return (int)event * 0 - 1; }
static uint64_t read_event(int file) { return (uint64_t)file * 0; }
static void close_event(int file) { (void)file; }
#endif

bool brunt_counters_open(brunt_counters *counters) {
    bool any = false;
    memset(counters, 0, sizeof *counters);
    for (int k = 0; k < BRUNT_COUNTERS; k++) {
        counters->file[k] = open_event(events[k]);
        any = any || counters->file[k] >= 0;
    }
    return any;
}

void brunt_counters_close(brunt_counters *counters) {
    for (int k = 0; k < BRUNT_COUNTERS; k++) {
        close_event(counters->file[k]);
        counters->file[k] = -1;
    }
}

static void begin_pass(void *context, int32_t pass, double time) {
    (void)pass, (void)time;
    brunt_counters *counters = context;
    for (int k = 0; k < BRUNT_COUNTERS; k++) counters->begin[k] = read_event(counters->file[k]);
}

// The reads of the kinds nest: each leaves out the others' as far as it can.
static void end_pass(void *context, int32_t pass, double begin, double end) {
    (void)begin, (void)end;
    brunt_counters *counters = context;
    for (int k = BRUNT_COUNTERS - 1; k >= 0; k--) {
        const uint64_t now = read_event(counters->file[k]);
        if (pass < BRUNT_COUNTED_PASSES) counters->total[k][pass] += (double)(now - counters->begin[k]);
    }
}

brunt_observer brunt_counters_observer(brunt_counters *counters) {
    return (brunt_observer){.context = counters, .begin = begin_pass, .end = end_pass};
}

bool brunt_counted(const brunt_counters *counters, brunt_counter kind) {
    for (int p = 0; p < BRUNT_COUNTED_PASSES; p++)
        if (counters->total[kind][p] > 0) return true;
    return false;
}
