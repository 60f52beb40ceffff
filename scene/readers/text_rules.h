// Rules that all text formats of models share: decimal commas, comments after names, numbers of lines.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.h"

namespace umbrage {

/// Returns whether commas are decimal points in a word or line, as in "0,5 1,0" or "1,5;2,5": between blanks or
/// semicolons is one comma, between two digits, and no point. Readers call it where a number is not followed by a
/// blank.
bool has_decimal_commas(std::string_view text);

/// Returns the error for a file with decimal commas in the line with this number. They are refused, not read, since in
/// other files commas separate numbers.
Error decimal_commas_error(const std::string& file, std::size_t line);

/// Returns the number, from 1, of the line at this place of a text whose lines end in LF, CR LF or CR.
std::size_t line_number_at(std::string_view text, const char* at);

/// Returns a name without the comment after it: from a word that begins with '#', unless it is the first word or goes
/// on with a digit, as in "Material #25".
std::string_view without_comment(std::string_view name);

}  // namespace umbrage
