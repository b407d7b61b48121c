#include "voml/diagnostics.h"
