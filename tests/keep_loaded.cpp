// Linked to programs under the leak sanitizer: libraries stay loaded to the end. Leaks of a Vulkan driver have no
// symbol names after the loader has unloaded it, and then no suppression matches.
extern "C" __attribute__((visibility("default"))) int dlclose(void*) noexcept { return 0; }
