// Preloaded into becalm, this makes Embree choose what it would on a processor that has no more than SSE4.2.
// A choice of becalm's own is left as it is.

#include <dlfcn.h>

extern "C" void* rtcNewDevice(const char* config) {
  using NewDevice = void* (*)(const char*);
  const auto original = reinterpret_cast<NewDevice>(dlsym(RTLD_NEXT, "rtcNewDevice"));
  return original(config == nullptr ? "isa=sse4.2" : config);
}
