// The one parameter of kernels that need no other: the size that they are dispatched over. The chain supplies it.
layout(push_constant) uniform Sizes { ivec2 size; };
