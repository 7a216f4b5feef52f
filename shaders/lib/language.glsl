// Files of shaders/lib/ that include this one hold pure functions, which compile as GLSL and as C++.
// tests/filter/glsl.h includes those that are unit-tested. OUT marks a parameter that the function writes.
#ifdef __cplusplus
#define OUT(type) type&
#else
#define OUT(type) out type
#endif
