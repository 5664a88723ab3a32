// Gravity, which a ramp may bring in.
#pragma once

#include "body/settings.h"

// Its acceleration at a time [m/s^2].
void brunt_gravity_at(const brunt_settings *settings, double time, double gravity[3]);
