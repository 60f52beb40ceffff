// The format of a model: by its content, else by its name. The same rules apply to files and to standard input.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace umbrage {

/// Returns the format of a model, or of something that is often in its place (a web page, an archive), by its content:
/// a file extension without the dot, "html", "lfs" or "utf16"; empty if unknown. `start`: the first kContentBytes bytes
/// or more. `size`: of all of it; 0: unknown.
std::string format_of_content(std::string_view start, std::size_t size);
inline constexpr std::size_t kContentBytes = std::size_t(1) << 16;

/// Returns the format by which to read a file: that of its content, if it is known and not another name of the one that
/// its extension tells; else that of its extension, as import_format returns it.
std::string format_of_file(const std::filesystem::path& file);

/// Returns whether a format is one that umbrage-import-cad reads.
bool is_cad(std::string_view format);

/// Returns the unit of length of formats that define one, such as "gltf", or to which its reader converts; else an
/// empty string. The formats that Assimp reads are not converted to metres.
std::string units_of(const std::string& format);

/// Returns what a format is that is not read and what to do, as "a CAD format that is not read; ..."; empty for others.
std::string conversion_advice(std::string_view format);

}  // namespace umbrage
