# Runs in a bare system, by scripts/archive --try: try_archive.sh VERSION. Prints the hashes of pictures.
set -eu
cd out/archive/try
place="Ünpacked hére/umbrage-$1"
useradd -m someone 2>/dev/null || true
chown -R someone .
as_user() { setpriv --reuid=someone --regid=someone --clear-groups env HOME=/home/someone "$@"; }
as_user "$place/bin/umbrage" --version
for isa in sse4 avx2; do
  for look in studio ao unsharp cartoon; do
    as_user "$place/bin/umbrage" bunny.obj --device cpu --isa $isa --look $look --resolution 320x240 -o $look-$isa.png
  done
done
as_user "$place/bin/umbrage" ring.step --device cpu --resolution 320x240 -o ring.png
as_user "$place/bin/umbrage" bench bunny.obj --effect unsharp --resolution 64 --runs 1 --device cpu >/dev/null
as_user "$place/bin/umbrage" list devices
sha256sum ./*.png
# Moved while it runs: a picture that was begun is finished.
as_user "$place/bin/umbrage" bunny.obj --device cpu --quality ultra --resolution 1600x1200 -o moved.png &
sleep 0.5
mv "$place" ./moved
kill -0 $! # it still draws
wait $!
[ -s moved.png ]
as_user moved/bin/umbrage bunny.obj --device cpu -o again.png
# As a library, with Python and with a compiler.
apt-get update -q >/dev/null
apt-get install -qy --no-install-recommends python3-numpy g++ pkg-config >/dev/null
as_user env PYTHONPATH="$PWD/moved/python" python3 -c '
import umbrage
print(umbrage.render("bunny.obj", size=(64, 64), device="cpu"), umbrage.__version__)'
# shellcheck disable=SC2046
as_user sh -c 'g++ -std=c++17 render_file.cpp -o render_file $(PKG_CONFIG_PATH=moved/lib/pkgconfig pkg-config --cflags --libs umbrage) -Wl,-rpath,"$PWD/moved/lib"
  ./render_file bunny.obj library.image.png'
