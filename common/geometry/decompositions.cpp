#include "common/geometry/decompositions.h"

SGRAPHS_DECOMPOSITIONS(, 3);
SGRAPHS_DECOMPOSITIONS(, 6);
SGRAPHS_DECOMPOSITIONS(, Eigen::Dynamic);
