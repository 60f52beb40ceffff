/* Umbrage's effects on a caller's own Vulkan device and images: for engines that draw themselves and want the shading.
 *
 * C99 or later; needs Vulkan's headers. Handles, errors and spaces are those of umbrage/umbrage.h. C++ programs may use
 * umbrage/vulkan.hpp; examples/vulkan_images.cpp is a whole program around it. */
#ifndef UMBRAGE_VULKAN_H
#define UMBRAGE_VULKAN_H
#include <vulkan/vulkan_core.h>

#include "umbrage/umbrage.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The caller's device: Vulkan 1.2 or later, with the features bufferDeviceAddress and scalarBlockLayout enabled, which
 * binds 16 storage buffers to a shader (maxPerStageDescriptorStorageBuffers). */
typedef struct UmbVulkanContext {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  VkQueue queue; /* computes; nobody else may use it during a call */
  uint32_t queue_family;
} UmbVulkanContext;

/* A 2D image: its first level and layer, of the picture's size. Formats: R32_SFLOAT, D32_SFLOAT (read alone),
 * R16G16B16A16_SFLOAT, R32G32B32A32_SFLOAT, R8G8B8A8 and B8G8R8A8 as UNORM or SRGB. What is read has the usage
 * TRANSFER_SRC, what is written TRANSFER_DST. It belongs to the queue's family, or is shared. */
typedef struct UmbVulkanImage {
  VkImage image;
  VkFormat format;
  VkImageLayout layout;       /* in which it comes */
  VkImageLayout layout_after; /* and is left */
} UmbVulkanImage;

/* The parameter "depth_kind" as numbers. */
typedef enum UmbDepthKind {
  UMB_DEPTH_VIEW = 0,    /* distance along the view axis */
  UMB_DEPTH_RAY = 1,     /* distance from the eye along the pixel's ray */
  UMB_DEPTH_WINDOW = 2,  /* 0 at the near plane, 1 at the far plane */
  UMB_DEPTH_REVERSED = 3 /* 1 at the near plane, 0 at the far plane */
} UmbDepthKind;

/* What shading starts from. Images without a handle are not there. */
typedef struct UmbVulkanGBuffer {
  int32_t width, height;
  UmbVulkanImage depth;
  int32_t depth_kind;          /* UmbDepthKind */
  float near_plane, far_plane; /* of UMB_DEPTH_WINDOW and _REVERSED; a far_plane of 0 is infinity */
  /* Unit vectors to the surface's outside, bytes from [0, 1] to [-1, 1]. Without an image they follow from depth. */
  UmbVulkanImage normal;
  /* Normals are turned by the rows of this rotation to view space; all 0: they are in it. */
  float view_from_normal[9];
  UmbVulkanImage albedo; /* diffuse reflectance; without: grey */
  UmbVulkanImage light;  /* light that surfaces send to the eye, linear; for effects that change it */
  int32_t orthographic;
  /* The window that the image fills: at distance 1, or in scene units for an orthographic camera. */
  float left, right, bottom, top;
  float scene_radius; /* bounding sphere's radius, which relative lengths are shares of */
} UmbVulkanGBuffer;

/* Planes for an image's channels: "ao", or "indirect.r", "indirect.g", "indirect.b". */
typedef struct UmbVulkanOutput {
  const char* const* planes;
  int32_t plane_count;
  UmbVulkanImage image;
} UmbVulkanOutput;

typedef struct UmbVulkanWork {
  const char* const* effects; /* one after the other, such as "bitmask", "denoise" */
  int32_t effect_count;
  const char* const* settings; /* "effect.parameter=value" */
  int32_t setting_count;
  const UmbVulkanOutput* outputs;
  int32_t output_count;
  VkSemaphore wait;   /* that the G-buffer is there; null: it was submitted to this queue before */
  VkSemaphore signal; /* that the outputs are */
} UmbVulkanWork;

/* Effects on a caller's device. One call at a time; to be released before the device ends. */
typedef struct UmbVulkanShadingObject* UmbVulkanShading;

/* Errors: UMB_ERROR_DEVICE where the device does not have what is needed. */
UMB_API UmbVulkanShading umbNewVulkanShading(const UmbVulkanContext* context);
UMB_API void umbRetainVulkanShading(UmbVulkanShading shading);
UMB_API void umbReleaseVulkanShading(UmbVulkanShading shading);
UMB_API UmbError umbGetVulkanShadingError(UmbVulkanShading shading, const char** message);

/* Submits once and returns without waiting. The next call waits for the one before. An effect that works on the host,
 * too, as "outline" does, has what comes before it submitted first, and waits for that. Errors: UMB_ERROR_USAGE for
 * names and formats that there are not, UMB_ERROR_DEVICE where memory is short or the device is lost; after
 * UMB_ERROR_USAGE nothing has been submitted but that. */
UMB_API UmbError umbShadeVulkanImages(UmbVulkanShading shading, const UmbVulkanGBuffer* gbuffer,
                                      const UmbVulkanWork* work);
/* Waits for the last one. Errors: UMB_ERROR_DEVICE. */
UMB_API UmbError umbFinishVulkanShading(UmbVulkanShading shading);
/* Bytes of device memory that it holds, for this and the next pictures of the size. */
UMB_API uint64_t umbGetVulkanShadingMemory(UmbVulkanShading shading);

#ifdef __cplusplus
}
#endif
#endif
