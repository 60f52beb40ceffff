/* Runs Umbrage's effects on a Vulkan device and images of the caller: for engines that draw a G-buffer themselves.
 *
 * C99 or later; needs Vulkan's headers. Handles, errors and spaces are those of umbrage/umbrage.h. C++ programs may use
 * umbrage/vulkan.hpp; examples/vulkan_images.cpp is a complete program that uses it. */
#ifndef UMBRAGE_VULKAN_H
#define UMBRAGE_VULKAN_H
#include <vulkan/vulkan_core.h>

#include "umbrage/umbrage.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The caller's device: Vulkan 1.2 or later, with the features bufferDeviceAddress and scalarBlockLayout enabled and a
 * maxPerStageDescriptorStorageBuffers of at least 16. */
typedef struct UmbVulkanContext {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  VkQueue queue; /* must support compute; nothing else may use it during a call */
  uint32_t queue_family;
} UmbVulkanContext;

/* A 2D image of the picture's size; mip level 0 and array layer 0 are used. Formats: R32_SFLOAT, D32_SFLOAT (input
 * only), R16G16B16A16_SFLOAT, R32G32B32A32_SFLOAT, R8G8B8A8 and B8G8R8A8 as UNORM or SRGB. Inputs need the usage
 * TRANSFER_SRC, outputs TRANSFER_DST. The queue's family owns the image, or the sharing mode is concurrent. */
typedef struct UmbVulkanImage {
  VkImage image;
  VkFormat format;
  VkImageLayout layout;       /* before the call */
  VkImageLayout layout_after; /* after the call */
} UmbVulkanImage;

/* The values of the parameter "depth_kind" as numbers. */
typedef enum UmbDepthKind {
  UMB_DEPTH_PLANAR = 0,   /* distance along the view axis */
  UMB_DEPTH_DISTANCE = 1, /* distance from the camera along the pixel's ray */
  UMB_DEPTH_WINDOW = 2,   /* 0 at the near plane, 1 at the far plane */
  UMB_DEPTH_REVERSED = 3  /* 1 at the near plane, 0 at the far plane */
} UmbDepthKind;

/* Inputs of shading. An image with a null handle is absent. */
typedef struct UmbVulkanGBuffer {
  int32_t width, height;
  UmbVulkanImage depth;
  int32_t depth_kind;          /* UmbDepthKind */
  float near_plane, far_plane; /* for UMB_DEPTH_WINDOW and _REVERSED; a far_plane of 0 means infinity */
  /* Unit vectors that point outwards; UNORM bytes map [0, 1] to [-1, 1]. Without an image normals are computed from
   * depth. */
  UmbVulkanImage normal;
  /* Rotation from the space of the normals to view space, row by row; all 0: the normals are in view space. */
  float view_from_normal[9];
  UmbVulkanImage albedo; /* diffuse reflectance; default: grey */
  UmbVulkanImage light;  /* linear radiance towards the camera, for effects that change it */
  int32_t orthographic;
  /* View window of the image: at distance 1, or in scene units for an orthographic camera. */
  float left, right, bottom, top;
  float scene_radius; /* bounding-sphere radius, scene units, > 0; relative lengths refer to it */
} UmbVulkanGBuffer;

/* An image and the planes that are written to its channels: "ao", or "indirect.r", "indirect.g", "indirect.b". */
typedef struct UmbVulkanOutput {
  const char* const* planes;
  int32_t plane_count;
  UmbVulkanImage image;
} UmbVulkanOutput;

typedef struct UmbVulkanWork {
  const char* const* effects; /* run in this order, such as "bitmask", "denoise" */
  int32_t effect_count;
  const char* const* settings; /* "effect.parameter=value" */
  int32_t setting_count;
  const UmbVulkanOutput* outputs;
  int32_t output_count;
  VkSemaphore wait;   /* signalled when the G-buffer is ready; null: it was submitted to this queue before */
  VkSemaphore signal; /* to be signalled when the outputs are ready */
} UmbVulkanWork;

/* Recordings that may be in flight at a time. */
#define UMB_VULKAN_SLOTS 8

/* Runs effects on the caller's device. Allows one call at a time. Must be released before the device is destroyed. */
typedef struct UmbVulkanShadingObject* UmbVulkanShading;

/* Errors: UMB_ERROR_USAGE for a missing handle; UMB_ERROR_DEVICE if the device lacks a required feature. */
UMB_API UmbVulkanShading umbNewVulkanShading(const UmbVulkanContext* context);
UMB_API void umbRetainVulkanShading(UmbVulkanShading shading);
UMB_API void umbReleaseVulkanShading(UmbVulkanShading shading);
UMB_API UmbError umbGetVulkanShadingError(UmbVulkanShading shading, const char** message);

/* Submits the work once and returns without waiting for it. The next call waits for the previous one. For an effect
 * that also runs on the host, such as "outline", the call first submits the preceding work and waits for it. Errors:
 * UMB_ERROR_USAGE for unknown names and formats; UMB_ERROR_DEVICE if memory runs out or the device is lost. After
 * UMB_ERROR_USAGE nothing has been submitted except such preceding work. */
UMB_API UmbError umbShadeVulkanImages(UmbVulkanShading shading, const UmbVulkanGBuffer* gbuffer,
                                      const UmbVulkanWork* work);
/* Records the work of umbShadeVulkanImages into a command buffer of the caller, and submits nothing.
 *
 * `commands` is in the recording state, outside of render passes; its pool is of the context's queue family. It is
 * submitted once, to the context's queue, in any order; or to another queue of the family, if semaphores keep the
 * recordings of this object from running at the same time. A recording begins and ends with full barriers: the images
 * need no others, and go from their `layout` to their `layout_after`. The pipeline, descriptor sets and push constants
 * of the compute bind point are undefined after it. `wait` and `signal` must be null.
 *
 * A `slot`, 0 to UMB_VULKAN_SLOTS - 1, owns what its last recording needs. So use one for each frame in flight, and
 * record into it again, or release the object, only when the fence of its submission is signalled or its command buffer
 * was reset. The caller's images must exist as long. All slots share the planes between the effects: more frames in
 * flight take no more memory. The first recording of an effect compiles it, which may take seconds, and the first one
 * of a picture size allocates memory; others neither compile, allocate nor wait.
 *
 * Errors: those of umbShadeVulkanImages; UMB_ERROR_USAGE also for effects with work on the host, such as "outline", and
 * for rays, by name, for other slots, and for more than some hundred dispatches. After an error the command buffer may
 * contain a part of the work: reset it. */
UMB_API UmbError umbRecordVulkanImages(UmbVulkanShading shading, VkCommandBuffer commands, int32_t slot,
                                       const UmbVulkanGBuffer* gbuffer, const UmbVulkanWork* work);

/* What a recording costs. Bytes: each dispatch reads and writes each of its planes once, 4 bytes a pixel, though
 * kernels also read around a pixel; the conversions of the caller's images are included. */
typedef struct UmbVulkanCost {
  int32_t dispatches;
  uint64_t bytes_read, bytes_written;
  double milliseconds; /* on the device; 0: its fence is not signalled, or the queue has no timestamps */
} UmbVulkanCost;
/* Gets the cost of the slot's last recording; all 0 without one. Errors: UMB_ERROR_USAGE for other slots. */
UMB_API UmbError umbGetVulkanCost(UmbVulkanShading shading, int32_t slot, UmbVulkanCost* cost);

/* Waits for the last submission. Errors: UMB_ERROR_DEVICE. */
UMB_API UmbError umbFinishVulkanShading(UmbVulkanShading shading);
/* Returns the device memory that is allocated for this and later pictures of the same size, in bytes. */
UMB_API uint64_t umbGetVulkanShadingMemory(UmbVulkanShading shading);

#ifdef __cplusplus
}
#endif
#endif
