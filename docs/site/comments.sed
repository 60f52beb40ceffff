# Marks the comments of the public headers for doxygen: the first one describes the file.
1s,^/\* (.*),/** @file\n * \1,
1s,^// (.*),/// @file\n/// \1,
/\/\* ----/b
2,/^#(pragma|ifndef)/s,^//( |$),///\1,
s,^( *)/\* ,\1/** ,
s,([;\,{}A-Za-z0-9_)] *)/\* ,\1/**< ,
