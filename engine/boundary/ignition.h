// When explosives are lit.
#pragma once

#include "base/messages.h"
#include "body/bodies.h"

// After the bodies are made, before their particles are sorted. BRUNT_BAD_INPUT for detonations that light nothing.
int brunt_ignition_make(const brunt_bodies *bodies, const brunt_world_def *def, brunt_messages *messages,
                        brunt_error *error);
