// The one parameter of kernels that need no other: the size that they are dispatched over. The chain supplies it.
layout(push_constant) uniform DispatchSize { int width; int height; } p;
