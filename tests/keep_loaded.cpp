// Replaces dlclose in programs under the leak sanitizer, so that libraries stay loaded to the end. After the loader has
// unloaded a Vulkan driver, leaks of the driver have no symbol names, and no suppression matches them.
extern "C" __attribute__((visibility("default"))) int dlclose(void*) noexcept { return 0; }
