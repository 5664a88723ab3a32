// Several observers of a world's steps as one (the world knows one).
#pragma once

#include "brunt.h"

enum { BRUNT_OBSERVER_LIMIT = 4 };

typedef struct brunt_observers {
    brunt_observer list[BRUNT_OBSERVER_LIMIT];
    int count;
} brunt_observers;

// Begins of passes are told in the order in which they were added, ends in the reverse of it: what is added last
// measures the least of the others.
void brunt_observers_add(brunt_observers *observers, brunt_observer observer);
// From now on the world tells them, which must stay where they are; without any, it tells none.
void brunt_observers_watch(brunt_observers *observers, brunt_world *world);
