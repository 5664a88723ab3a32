// Every block carries a 64-byte header that holds its size and where it begins, so that the live bytes are known
// without a table.
#include "base/memory.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { HEADER = 64, HUGE_PAGE = 1 << 21, LARGE = 1 << 21 };

static atomic_size_t live, peak;
static atomic_llong calls;

typedef struct header {
    size_t total;
    void *base; // what is freed
} header;

void *brunt_alloc(size_t bytes) {
    if (bytes > SIZE_MAX - 2 * HUGE_PAGE) return NULL;
    const size_t total = (bytes + 2 * HEADER - 1) / HEADER * HEADER;
    const bool large = total >= LARGE;
    const size_t align = large ? HUGE_PAGE : HEADER;
    // Of large blocks no page is touched: they are zero as they come, those that stay unused take no memory, and the
    // threads that use the others first fetch them.
    char *base = calloc(1, total + align);
    if (!base) return NULL;
    char *block = base + (align - (uintptr_t)base % align);
    // A pass over particles reads thirty arrays side by side: in small pages that is thirty entries of the translation
    // buffer every block.
    if (large) madvise(block, total, MADV_HUGEPAGE);
    *(header *)block = (header){total, base};
    size_t now = atomic_fetch_add(&live, total) + total, seen = atomic_load(&peak);
    while (now > seen && !atomic_compare_exchange_weak(&peak, &seen, now)) {}
    atomic_fetch_add(&calls, 1);
    return block + HEADER;
}

void brunt_free(void *memory) {
    if (!memory) return;
    const header *own = (header *)((char *)memory - HEADER);
    atomic_fetch_sub(&live, own->total);
    free(own->base);
}

size_t brunt_memory_live(void) { return atomic_load(&live); }
size_t brunt_memory_peak(void) { return atomic_load(&peak); }
int64_t brunt_memory_calls(void) { return atomic_load(&calls); }
