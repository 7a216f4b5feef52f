// The skeleton that all pages of the project share, and this page's content, each between two symbols.
    .section .rodata
    .globl becalm_page_skeleton, becalm_page_skeleton_end, becalm_test_page, becalm_test_page_end
becalm_page_skeleton:
    .incbin "scripts/pictures/page.html"
becalm_page_skeleton_end:
becalm_test_page:
    .incbin "app/test/test_page.html"
becalm_test_page_end:
    .section .note.GNU-stack, "", %progbits
