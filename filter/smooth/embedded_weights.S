// The files of weights/, as they are, each between two symbols.
    .section .rodata
    .balign 16
    .globl becalm_frame_weights, becalm_frame_weights_end
becalm_frame_weights:
    .incbin "frames.weights"
becalm_frame_weights_end:
    .globl becalm_merged_weights, becalm_merged_weights_end
becalm_merged_weights:
    .incbin "merged.weights"
becalm_merged_weights_end:
    .section .note.GNU-stack, "", %progbits
