#include "boundary/gravity.h"

void brunt_gravity_at(const brunt_settings *settings, double time, double gravity[3]) {
    const bool ramp = settings->gravity_ramp > 0 && time < settings->gravity_ramp;
    const double share = ramp ? time / settings->gravity_ramp : 1;
    for (int a = 0; a < 3; a++) gravity[a] = a < settings->dimension ? share * settings->gravity[a] : 0;
}
