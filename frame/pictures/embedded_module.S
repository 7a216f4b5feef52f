// The module of module.cpp, as it is, between two symbols.
    .section .rodata
    .balign 16
    .globl becalm_pictures_module, becalm_pictures_module_end
becalm_pictures_module:
    .incbin "becalm_pictures_module.so"
becalm_pictures_module_end:
    .section .note.GNU-stack, "", %progbits
