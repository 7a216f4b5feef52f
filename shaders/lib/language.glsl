// Files of shaders/lib/ that include this one hold pure functions. They compile as GLSL and, after
// tests/filter/glsl.h, as C++, where they are unit-tested. OUT marks a parameter that the function writes.
#ifdef __cplusplus
#define OUT(type) type&
#else
#define OUT(type) out type
#endif
