// Part of every test executable that is built with the address sanitizer: what it may not report.

/// Nothing is unloaded: the Vulkan loader closes drivers and layers with the last instance, and what they
/// still held would then be reported as leaks of an unknown module.
extern "C" int dlclose(void*) noexcept {
  return 0;
}

/// The validation layer of Debian 12 (1.3.239) keeps cycles of shared pointers for the buffers and command
/// buffers that it has tracked. Drivers are not on this list: what they leave behind counts.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the name is the interface
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libVkLayer_khronos_validation.so\n";
}

/// Tests ask software devices for more memory than there is, which is refused without the sanitizer, too.
/// What is freed waits in a short queue: images in a long one would be as many new pages for every new image,
/// which takes most of some tests' time.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the name is the interface
extern "C" const char* __asan_default_options() {
  return "allocator_may_return_null=1:quarantine_size_mb=16";
}
