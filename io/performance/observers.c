#include "io/performance/observers.h"

#include <stddef.h>

#include "base/error.h"

static void begin(void *context, int32_t pass, double time) {
    const brunt_observers *all = context;
    for (int i = 0; i < all->count; i++)
        if (all->list[i].begin) all->list[i].begin(all->list[i].context, pass, time);
}

static void thread(void *context, int32_t pass, int32_t worker, double from, double to) {
    const brunt_observers *all = context;
    for (int i = 0; i < all->count; i++)
        if (all->list[i].thread) all->list[i].thread(all->list[i].context, pass, worker, from, to);
}

static void end(void *context, int32_t pass, double from, double to) {
    const brunt_observers *all = context;
    for (int i = all->count - 1; i >= 0; i--)
        if (all->list[i].end) all->list[i].end(all->list[i].context, pass, from, to);
}

void brunt_observers_add(brunt_observers *observers, brunt_observer observer) {
    BRUNT_ASSERT(observers->count < BRUNT_OBSERVER_LIMIT);
    observers->list[observers->count++] = observer;
}

void brunt_observers_watch(brunt_observers *observers, brunt_world *world) {
    brunt_observer one = {.context = observers, .begin = begin, .end = end};
    for (int i = 0; i < observers->count; i++)
        if (observers->list[i].thread) one.thread = thread; // phases are told only to observers of threads
    brunt_world_observe(world, observers->count ? &one : NULL);
}
