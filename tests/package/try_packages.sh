# Runs in a bare system, by scripts/package --try: installs the packages, draws with the program, the library and Python,
# and removes the packages.
set -eu
work=/root/work
mkdir $work
cp out/packages/*.deb examples/render_file.cpp examples/*.c examples/python/*.py examples/gallery.ipynb tests/cad/ring.step $work/
cd $work
# A model of a format that umbrage-import reads.
printf 'v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >model.obj
install() { apt-get install -qy --no-install-recommends "$@" >/dev/null; }
apt-get update -q >/dev/null

echo "package: the program"
install ./umbrage_*.deb
umbrage --version
umbrage scene:pink -o pink.png
umbrage model.obj -o model.png
umbrage list devices
echo "package: the laboratory"
if umbrage bench model.obj --runs 1; then exit 1; fi
install ./umbrage-lab_*.deb
umbrage bench model.obj --effect unsharp --resolution 64 --runs 1
echo "package: STEP"
if umbrage ring.step -o ring.png; then exit 1; fi
install ./umbrage-import-cad_*.deb
umbrage ring.step -o ring.png
echo "package: the library, with programs in C++ and C"
install ./libumbrage*.deb g++ pkg-config
# shellcheck disable=SC2046
g++ -std=c++17 render_file.cpp -o render_file $(pkg-config --cflags --libs umbrage)
./render_file model.obj library.png
umbrage model.obj -o same.png --resolution 640x480 --camera-azimuth-angle 20
cmp library.png same.png
for name in shade_arrays_c render_mesh_c; do
  # shellcheck disable=SC2046
  gcc -std=c99 -pedantic -Wall -Wextra -Werror $name.c -o $name $(pkg-config --cflags --libs umbrage) -lm
  ./$name $name.png
done
echo "package: the Python package and its notebook"
install ./python3-umbrage*.deb python3-nbclient python3-ipykernel
python3 -c 'import umbrage; umbrage.render("model.obj").save("python.png")'
cmp python.png model.png
python3 depth_map.py relief.png
python3 numpy_mesh.py wave.png 64
python3 thumbnails.py thumbnails model.obj
UMBRAGE_GALLERY_SIZE=64 python3 -c '
import nbclient, nbformat
nbclient.NotebookClient(nbformat.read("gallery.ipynb", 4), kernel_name="python3").execute()'
ls -l ./*.png
echo "package: removing all packages"
apt-get purge -qy umbrage umbrage-lab umbrage-import-cad "libumbrage*" python3-umbrage >/dev/null
if find / -xdev -path /proc -prune -o -path $work -prune -o -path /checkout -prune -o -name "*umbrage*" -print | grep .; then
  echo "package: these files remain after removal" >&2
  exit 1
fi
