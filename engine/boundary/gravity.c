#include "boundary/gravity.h"

void brunt_gravity_at(const brunt_settings *settings, double time, double gravity[3]) {
    const bool ramp = settings->given.gravity_ramp > 0 && time < settings->given.gravity_ramp;
    const double share = ramp ? time / settings->given.gravity_ramp : 1;
    for (int a = 0; a < 3; a++) gravity[a] = a < settings->dimension ? share * settings->given.gravity[a] : 0;
}
