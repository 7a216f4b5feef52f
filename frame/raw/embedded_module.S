// The module of module.cpp, as it is, between two symbols.
    .section .rodata
    .balign 16
    .globl becalm_raw_module, becalm_raw_module_end
becalm_raw_module:
    .incbin "becalm_raw_module.so"
becalm_raw_module_end:
    .section .note.GNU-stack, "", %progbits
