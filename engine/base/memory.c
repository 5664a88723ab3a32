// Every block carries a 64-byte header that holds its size, so that the live bytes are known without a table.
#include "base/memory.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { HEADER = 64, HUGE_PAGE = 1 << 21, LARGE = 1 << 23 };

static atomic_size_t live, peak;
static atomic_llong calls;

void *brunt_alloc(size_t bytes) {
    if (bytes > SIZE_MAX - 2 * HEADER) return NULL;
    size_t total = (bytes + 2 * HEADER - 1) / HEADER * HEADER;
    bool large = total >= LARGE;
    if (large) total = (total + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    char *block = aligned_alloc(large ? HUGE_PAGE : HEADER, total);
    if (!block) return NULL;
    // A pass over particles reads thirty arrays side by side: in small pages that is thirty entries of the translation
    // buffer every block.
    if (large) madvise(block, total, MADV_HUGEPAGE);
    memset(block, 0, total);
    *(size_t *)block = total;
    size_t now = atomic_fetch_add(&live, total) + total, seen = atomic_load(&peak);
    while (now > seen && !atomic_compare_exchange_weak(&peak, &seen, now)) {}
    atomic_fetch_add(&calls, 1);
    return block + HEADER;
}

void brunt_free(void *memory) {
    if (!memory) return;
    char *block = (char *)memory - HEADER;
    atomic_fetch_sub(&live, *(size_t *)block);
    free(block);
}

size_t brunt_memory_live(void) { return atomic_load(&live); }
size_t brunt_memory_peak(void) { return atomic_load(&peak); }
int64_t brunt_memory_calls(void) { return atomic_load(&calls); }
