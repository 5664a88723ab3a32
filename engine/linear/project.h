// Small symmetric matrices without their negative eigenvalues, for stencils of a term that are to be projected.
#pragma once

// Takes the negative eigenvalues of a symmetric matrix of n <= 12 rows away.
void brunt_project_positive(int n, double *h);
