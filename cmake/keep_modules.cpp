// Part of every program that is built with sanitizers: no library is unloaded, so that what drivers keep to the end can
// still be told by its library's name (tests/drivers.lsan).
extern "C" int dlclose(void*) noexcept { return 0; }
