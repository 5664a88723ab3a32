// A membrane element whose area is below this part of its first one is about to fold through itself, where it has no
// normal. Smaller parts let the force on a fold grow, and shorten the stable step as their square.
#pragma once

#define BRUNT_CRUSHED 0.25
