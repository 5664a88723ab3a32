// Which bodies may meet, how, and what their contact has done.
#pragma once

#include "contact/contact.h"

typedef struct brunt_pairs {
    brunt_pair *pair;
    int count;
    int32_t *of; // [a * body_count + b]: index of the pair, -1
} brunt_pairs;
