// The files of weights/, as they are, each between two symbols.
    .section .rodata
    .balign 16
    .globl becalm_standard_weights, becalm_standard_weights_end
becalm_standard_weights:
    .incbin "standard.weights"
becalm_standard_weights_end:
    .globl becalm_shared_noise_weights, becalm_shared_noise_weights_end
becalm_shared_noise_weights:
    .incbin "shared_noise.weights"
becalm_shared_noise_weights_end:
    .globl becalm_albedo_weights, becalm_albedo_weights_end
becalm_albedo_weights:
    .incbin "albedo.weights"
becalm_albedo_weights_end:
    .globl becalm_own_share_weights, becalm_own_share_weights_end
becalm_own_share_weights:
    .incbin "own_share.weights"
becalm_own_share_weights_end:
    .section .note.GNU-stack, "", %progbits
