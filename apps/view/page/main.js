"use strict"; // [1;2] @x@ "\n"
