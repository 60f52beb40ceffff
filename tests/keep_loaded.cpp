// Linked to programs under the leak sanitizer: libraries stay loaded to the end. What a Vulkan driver leaks has no name
// once the loader has unloaded it, and then no suppression knows it.
extern "C" __attribute__((visibility("default"))) int dlclose(void*) noexcept { return 0; }
