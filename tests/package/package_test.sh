#!/usr/bin/env bash
# Runs one test of the installed library: package_test.sh NAME PLACE. Install installs into PLACE; the others use it.
set -euo pipefail
name=$1 place=$2
prefix=$place/moved

fail() {
  echo "package_test: $*" >&2
  exit 1
}

# run_examples FOLDER: runs the examples in FOLDER and checks their results. umbrage-import reads the model.
run_examples() {
  printf 'v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >"$1/model.obj"
  "$1/render_file" "$1/model.obj" "$1/render_file.png"
  [ "$(head -c 4 "$1/render_file.png" | tail -c 3)" = PNG ] || fail "render_file wrote no PNG file"
  [ -e "$1/shade_arrays" ] || return 0
  "$1/shade_arrays" "$1/shade_arrays.png"
  [ "$(head -c 4 "$1/shade_arrays.png" | tail -c 3)" = PNG ] || fail "shade_arrays wrote no PNG file"
  local code=0
  "$1/progress" 'scene:solids?detail=3000' 0.2 || code=$?
  [ "$code" = 130 ] || fail "progress ended with $code; 130 is expected"
}

# needs_shared FOLDER: prints yes if its programs need the shared library, else no.
needs_shared() { if [[ $(ldd "$1/render_file") == *libumbrage.so* ]]; then echo yes; else echo no; fi; }

# build_with_cmake FOLDER OPTIONS...: builds the examples as a separate project.
build_with_cmake() {
  local folder=$1
  shift
  rm -rf "$folder"
  "$CMAKE" -G Ninja -S "$SOURCE/examples" -B "$folder" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$CXX" \
    -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF "$@" >"$folder.log" 2>&1 || { cat "$folder.log"; fail "cmake refused it"; }
  grep -q "umbrage_DIR:PATH=$prefix/" "$folder/CMakeCache.txt" || fail "another umbrage was found"
  "$CMAKE" --build "$folder" --target render_file shade_arrays progress >"$folder.log" 2>&1 ||
    { cat "$folder.log"; fail "it does not build"; }
}

# build_with_pkg_config FOLDER FLAGS OPTIONS...: compiles an example with the flags from pkg-config.
build_with_pkg_config() {
  local folder=$1 flags=$2
  shift 2
  rm -rf "$folder"
  mkdir -p "$folder"
  export PKG_CONFIG_PATH=$PREFIX_USED/$LIB/pkgconfig
  # shellcheck disable=SC2046,SC2086
  "$CXX" -std=c++17 -Wall -Wextra -Werror "$SOURCE/examples/render_file.cpp" -o "$folder/render_file" \
    $(pkg-config $flags --cflags --libs umbrage) "$@"
}

case $name in
  Install)
    rm -rf "$place"
    "$CMAKE" --install "$BUILD" --prefix "$place/first" >/dev/null
    mv "$place/first" "$prefix"
    for file in bin/umbrage include/umbrage/umbrage.h include/umbrage/umbrage.hpp include/umbrage/vulkan.h "$LIB/pkgconfig/umbrage.pc" \
      "$LIB/cmake/umbrage/umbrage-config.cmake" share/doc/umbrage/LICENSE share/doc/umbrage/docs/library.md \
      share/doc/umbrage/examples/render_file.cpp share/man/man1/umbrage.1 \
      share/thumbnailers/umbrage.thumbnailer share/mime/packages/umbrage.xml libexec/umbrage/umbrage-import libexec/umbrage/umbrage-lab; do
      [ -s "$prefix/$file" ] || fail "$file is not installed"
    done
    # Links between the installed pages resolve.
    grep -rHo --include='*.md' '](\([^)# ]*\)[)#]' "$prefix/share/doc/umbrage" |
      sed -e 's/:](/ /' -e 's/[)#]$//' | grep -v -e ' $' -e ' [a-z]*:' | while read -r page link; do
      [ -e "$(dirname "$page")/$link" ] || echo "$page links to $link"
    done >"$place/broken_links"
    if [ -s "$place/broken_links" ]; then
      cat "$place/broken_links"
      fail "these links of installed pages lead nowhere"
    fi
    if grep -rIl -e "$place/first" -e "$BUILD" -e "$SOURCE" "$prefix" | grep .; then fail "these files contain folders of the build"; fi
    ;;
  Unbuilt)
    # Build trees like this one, of which only a part is built.
    refuses() { # MISSING BUILT...: an installation of the tree with these files names the missing one and writes nothing
      local tree=$place/unbuilt missing=$1 file code=0
      rm -rf "$tree"
      for file in "${@:2}"; do
        mkdir -p "$(dirname "$tree/$file")"
        cp -r "$BUILD/$file" "$tree/$file"
      done
      sed "s|$BUILD|$tree|g" "$BUILD/cmake_install.cmake" >"$tree/cmake_install.cmake"
      said=$("$CMAKE" -DCMAKE_INSTALL_PREFIX="$tree/prefix" -DCMAKE_INSTALL_LOCAL_ONLY=1 \
        -P "$tree/cmake_install.cmake" 2>&1 | tr -s ' \n' ' ') || code=$?
      [ "$code" != 0 ] || fail "an installation without $missing succeeded"
      [[ $said == *"/$missing is not built"*"cmake --build $tree --target umbrage_installation"* ]] ||
        fail "without $missing, the message does not say what to build: $said"
      [ ! -e "$tree/prefix" ] || fail "an installation without $missing was begun"
    }
    programs=(bin/umbrage bin/umbrage-import)
    [ ! -e "$BUILD/bin/umbrage-import-cad" ] || programs+=(bin/umbrage-import-cad)
    libraries=()
    case $KINDS in *shared*) libraries+=("libumbrage.so.$VERSION") ;; esac
    case $KINDS in *static*) libraries+=(libumbrage.a) ;; esac
    refuses bin/umbrage "${libraries[@]}"
    refuses man/man1/umbrage.1 "${programs[@]}" # as scripts/demo and `ninja umbrage` leave it
    refuses fish/vendor_completions.d/umbrage.fish "${programs[@]}" share/man share/bash-completion share/zsh
    refuses bin/umbrage-lab "${programs[@]}" share "${libraries[@]}"
    for library in "${libraries[@]}"; do
      # shellcheck disable=SC2046
      refuses "$library" "${programs[@]}" bin/umbrage-lab share $(printf '%s\n' "${libraries[@]}" | grep -vxF "$library")
    done
    # The target that the message names builds all of that, and no tests.
    ninja -C "$BUILD" -t query umbrage_installation | tr -d ' ' >"$place/inputs"
    for file in apps/umbrage_manual "${programs[@]}" bin/umbrage-lab "${libraries[@]%.$VERSION}"; do
      grep -qx "$file" "$place/inputs" || fail "umbrage_installation does not build $file"
    done
    ninja -C "$BUILD" -t inputs umbrage_installation >"$place/inputs"
    if grep _tests "$place/inputs"; then fail "umbrage_installation builds tests"; fi
    ;;
  Program)
    [ "$("$prefix/bin/umbrage" --version | head -n 1)" = "umbrage $VERSION" ] || fail "wrong version"
    "$prefix/bin/umbrage" 'scene:solids?detail=3000' --resolution 64x48 -o "$place/program.png"
    if ldd "$prefix/bin/umbrage" | grep libumbrage; then fail "the program needs the shared library"; fi
    "$prefix/bin/umbrage" bench 'scene:solids?detail=3000' --effect unsharp --resolution 64 --runs 1 --json |
      grep '"effect": "unsharp"' || fail "the program does not start umbrage-lab"
    lab=$prefix/libexec/umbrage/umbrage-lab
    [ "$("$lab" --version | head -n 1)" = "umbrage $VERSION" ] || fail "umbrage-lab has another version"
    said=$("$lab" --help)
    [[ $said == *compare*tune*figures*bench* && $said != *render* ]] || fail "umbrage-lab lists other commands: $said"
    code=0
    said=$("$lab" rendr 2>&1) || code=$?
    [[ $code = 2 && $said == "umbrage: "*"'rendr'"*compare* ]] || fail "umbrage-lab took 'rendr': $code, $said"
    ;;
  Headers)
    # Each header must compile alone, in all supported versions of the languages.
    for standard in c99 c17; do
      for header in umbrage vulkan; do
        echo "#include <umbrage/$header.h>" |
          "$CC" -std=$standard -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I "$prefix/include" -x c -
      done
    done
    for standard in c++17 c++20; do
      for header in umbrage.h vulkan.h umbrage.hpp vulkan.hpp; do
        echo "#include <umbrage/$header>" |
          "$CXX" -std=$standard -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I "$prefix/include" -x c++ -
      done
    done
    printf '#include <umbrage/umbrage.hpp>\nUmbError wide(umb::Job& job) { return job.set("width", 3u); }\n' |
      "$CXX" -std=c++17 -fno-exceptions -Wall -Wextra -Werror -fsyntax-only -I "$prefix/include" -x c++ -
    # The main header must include only standard headers.
    if grep '#include' "$prefix/include/umbrage/umbrage.h" | grep -v '<[a-z]*\.h>$'; then fail "umbrage.h includes other than standard headers"; fi
    ;;
  Symbols)
    library=$prefix/$LIB/libumbrage.so.$ABI
    [ -e "$library" ] || fail "the shared library is not called libumbrage.so.$ABI"
    readelf -d "$library" | grep "SONAME.*\[libumbrage\.so\.$ABI\]" || fail "the soname is wrong"
    # Within an ABI version functions may be added but not removed.
    nm -D --defined-only "$library" | sed -n 's/.* T //p' | LC_ALL=C sort |
      diff "$SOURCE/library/symbols.txt" - || fail "the exported functions differ from library/symbols.txt"
    ;;
  CMake)
    build_with_cmake "$place/cmake"
    run_examples "$place/cmake"
    case $KINDS in *shared*) [ "$(needs_shared "$place/cmake")" = yes ] || fail "not linked with the shared library" ;; esac
    # find_package must refuse a version that is too new, and an unknown component.
    for request in 99.0 "$VERSION COMPONENTS fancy"; do
      rm -rf "$place/request"
      mkdir "$place/request"
      printf 'cmake_minimum_required(VERSION 3.18)\nproject(request NONE)\nfind_package(umbrage %s QUIET)\nif(umbrage_FOUND)\n  message(FATAL_ERROR "found")\nendif()\n' \
        "$request" >"$place/request/CMakeLists.txt"
      "$CMAKE" -G Ninja -S "$place/request" -B "$place/request/build" -DCMAKE_PREFIX_PATH="$prefix" >"$place/request.log" 2>&1 ||
        { cat "$place/request.log"; fail "umbrage $request was found"; }
    done
    ;;
  CMakeStatic)
    build_with_cmake "$place/cmake-static" -DBUILD_SHARED_LIBS=OFF
    # A statically linked program does not know the folder of the library, but finds the program on PATH.
    PATH=$prefix/bin:$PATH run_examples "$place/cmake-static"
    [ "$(needs_shared "$place/cmake-static")" = no ] || fail "linked with the shared library"
    ;;
  Pip)
    # In a clone without a build folder, as docs/python.md says, but with the library of this build.
    rm -rf "$place/pip"
    mkdir -p "$place/pip/clone/python"
    cp -r "$SOURCE/setup.py" "$SOURCE/pyproject.toml" "$SOURCE/include" "$place/pip/clone/"
    cp -r "$SOURCE/python/umbrage" "$place/pip/clone/python/"
    cd "$place/pip"
    /usr/bin/python3 -m venv --system-site-packages environment
    UMBRAGE_BUILD=$BUILD environment/bin/pip install --no-index --no-build-isolation --no-deps ./clone >pip.log 2>&1 ||
      { cat pip.log; fail "pip failed"; }
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >model.obj
    said=$(env -u UMBRAGE_LIBRARY -u UMBRAGE_IMPORT PATH=/usr/bin:/bin environment/bin/python -c '
import umbrage
print(umbrage.__file__, umbrage.__version__, umbrage.render("model.obj", size=(48, 32), device="cpu").picture.shape)')
    [[ $said == "$place/pip/environment/"*" $VERSION (32, 48, 4)" ]] || fail "the package that pip installed says: $said"
    ;;
  PkgConfig)
    export PREFIX_USED=$prefix
    flags=
    case $KINDS in *shared*) ;; *) flags=--static ;; esac
    build_with_pkg_config "$place/pkg-config" "$flags" -Wl,-rpath,"$prefix/$LIB"
    [ "$(PKG_CONFIG_PATH=$prefix/$LIB/pkgconfig pkg-config --modversion umbrage)" = "$VERSION" ] || fail "wrong version"
    run_examples "$place/pkg-config"
    ;;
  PkgConfigStatic)
    # Make an installation with only the static library.
    export PREFIX_USED=$place/static
    rm -rf "$place/static"
    mkdir -p "$place/static"
    cp -r "$prefix/include" "$prefix/$(cut -d/ -f1 <<<"$LIB")" "$place/static/"
    rm -f "$place/static/$LIB"/libumbrage.so*
    build_with_pkg_config "$place/pkg-config-static" --static
    UMBRAGE_IMPORT=$prefix/libexec/umbrage/umbrage-import run_examples "$place/pkg-config-static"
    [ "$(needs_shared "$place/pkg-config-static")" = no ] || fail "linked with the shared library"
    ;;
  Debian)
    # Make packages as scripts/package does, except for the folder of the libraries, which depends on the prefix.
    rm -rf "$place/debian"
    mkdir -p "$place/debian"
    cpack --config "$BUILD/CPackConfig.cmake" -B "$place/debian" >"$place/debian.log" 2>&1 ||
      { cat "$place/debian.log"; fail "cpack failed"; }
    cd "$place/debian"
    release=$VERSION-1$(. /etc/os-release && [ "$ID" != debian ] || echo "${VERSION_ID:+~deb$VERSION_ID}")
    for package in umbrage umbrage-lab "libumbrage$ABI" libumbrage-dev; do
      file=$(echo "${package}"_*.deb)
      [ -s "$file" ] || fail "there is no package $package"
      [ "$(dpkg-deb -f "$file" Version)" = "$release" ] || fail "$file has another version"
      dpkg-deb -c "$file" | awk '{ print $6 }' >"$package.list"
      grep -qx "./usr/share/doc/$package/copyright" "$package.list" || fail "$file has no licence"
      if grep -v -e '/$' -e '^\./usr/' "$package.list"; then fail "$file has files outside /usr"; fi
    done
    # Each file must be in only one package.
    if cat ./*.list | grep -v '/$' | sort | uniq -d | grep .; then fail "these files are in two packages"; fi
    for file in bin/umbrage share/thumbnailers/umbrage.thumbnailer share/mime/packages/umbrage.xml; do
      grep -qx "./usr/$file" umbrage.list || fail "the package of the program lacks $file"
    done
    grep -q "/libumbrage\.so\.$ABI\$" "libumbrage$ABI.list" || fail "the shared library is missing"
    for file in umbrage.h libumbrage.so libumbrage.a umbrage.pc umbrage-config.cmake; do
      grep -q "/$file\$" libumbrage-dev.list || fail "libumbrage-dev lacks $file"
    done
    dpkg-deb -f umbrage_*.deb Depends | grep "libembree[34]" || fail "the program does not depend on what it is linked with"
    grep -qx ./usr/libexec/umbrage/umbrage-lab umbrage-lab.list || fail "the package of the laboratory lacks its program"
    dpkg-deb -f umbrage-lab_*.deb Depends | grep -F "umbrage (= $release)" || fail "the laboratory lacks its dependency"
    dpkg-deb -f libumbrage-dev_*.deb Depends | grep -F "libumbrage$ABI (= $release)" || fail "wrong dependency"
    dpkg-deb -x umbrage_*.deb unpacked
    unpacked/usr/bin/umbrage 'scene:solids?detail=3000' --resolution 64x48 -o "$place/unpacked.png"
    # Without umbrage-lab a message names it; an installed one would be found.
    if [ ! -e "$(sed -n 's/^CMAKE_INSTALL_PREFIX:.*=//p' "$BUILD/CMakeCache.txt")/libexec/umbrage/umbrage-lab" ]; then
      code=0
      said=$(PATH=$place unpacked/usr/bin/umbrage bench 2>&1) || code=$?
      [[ $code = 3 && $said == "umbrage: 'bench' "*umbrage-lab* ]] || fail "without umbrage-lab, bench ended with $code: $said"
    fi
    dpkg-deb -x umbrage-lab_*.deb unpacked
    unpacked/usr/bin/umbrage bench 'scene:solids?detail=3000' --effect unsharp --resolution 64 --runs 1
    ;;
  *) fail "there is no test $name" ;;
esac
