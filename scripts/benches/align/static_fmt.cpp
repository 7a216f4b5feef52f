// Those functions of libfmt.so that filter/ calls, for a program that links no shared library.

#include <fmt/format-inl.h>

template void fmt::detail::buffer<char>::append(const char*, const char*);
template auto fmt::detail::thousands_sep_impl<char>(fmt::detail::locale_ref)
    -> fmt::detail::thousands_sep_result<char>;
template auto fmt::detail::decimal_point_impl<char>(fmt::detail::locale_ref) -> char;
