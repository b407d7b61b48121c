#include "voml/files.h"
