// What a solved set has done, in the accounts of its pairs and planes. Private to the solution.
#pragma once

#include "contact/constraint/constraint.h"

// Adds up what the constraints of a chunk have done, from their rates, by the account; chunks in any order and by
// several threads.
void brunt_constraints_record(brunt_constraint_set *set, int64_t chunk);
// Then to the accounts what all chunks have, in their order.
void brunt_constraints_account(brunt_constraint_set *set);
