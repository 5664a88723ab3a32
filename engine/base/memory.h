// The one allocator. Every block is aligned to 64 bytes; the live bytes are readable, so that a leak is a failing test.
#pragma once

#include <stddef.h>
#include <stdint.h>

// Returns zeroed memory of `bytes` (at least 1), or NULL when there is none.
void *brunt_alloc(size_t bytes);
void brunt_free(void *memory);

size_t brunt_memory_live(void);   // [bytes] handed out and not given back
size_t brunt_memory_peak(void);   // [bytes] the most that was ever live
int64_t brunt_memory_calls(void); // allocations made so far: a step after warm-up must not change it
