// Contact of a world as a whole: freed, looked over.
#include "world/contact.h"

#include <math.h>

#include "base/error.h"
#include "contact/methods/method.h"

void brunt_contact_free(brunt_contact *contact) {
    brunt_surface_free(&contact->surface);
    brunt_constraints_free(&contact->constraints);
    brunt_node_to_facet_free(contact->node_to_facet);
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (brunt_contact_rows[r]->free) brunt_contact_rows[r]->free(contact->memory[r]);
}

void brunt_contact_validate(const brunt_contact *contact) {
    brunt_contact_methods_validate(contact->rows, contact->memory);
    brunt_constraints_validate(&contact->constraints);
    for (int a = 0; a < 3; a++) BRUNT_ASSERT(isfinite(contact->frame[a]));
    if (!contact->has_surfaces) return;
    brunt_surface_validate(&contact->surface);
    brunt_node_to_facet_validate(contact->node_to_facet, &contact->surface);
}
