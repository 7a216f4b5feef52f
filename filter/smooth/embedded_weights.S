// The file of weights/, as it is, between two symbols.
    .section .rodata
    .balign 16
    .globl becalm_standard_weights, becalm_standard_weights_end
becalm_standard_weights:
    .incbin "standard.weights"
becalm_standard_weights_end:
    .section .note.GNU-stack, "", %progbits
