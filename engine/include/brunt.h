// brunt: explicit-dynamics contact engine. The public C interface, whole: brunt/*.h are its parts.
//
// A world is made from a definition, stepped, read and destroyed. Definitions are plain structures: fill one with its
// default function first, so that a field added later keeps a sensible value. All quantities are SI. Nothing here
// prints or exits: what goes wrong comes back as a code and a brunt_error. Two worlds may live side by side.
#pragma once

#include "brunt/error.h"
#include "brunt/shape.h"
#include "brunt/mesh.h"
#include "brunt/material.h"
#include "brunt/body.h"
#include "brunt/boundary.h"
#include "brunt/definition.h"
#include "brunt/world.h"
#include "brunt/result.h"
#include "brunt/observe.h"
#include "brunt/state.h"
