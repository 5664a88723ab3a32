// The mark of a definition that was filled by its default function.
#pragma once

enum { BRUNT_WORLD_COOKIE = 0x6272756e };
