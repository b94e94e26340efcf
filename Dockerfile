# evbench as an image, by the scripts that also work without it:
#   docker build -t evbench .      (--build-arg DEBIAN=13 for another release)
#   docker run --rm -v "$PWD/results:/evbench/results" evbench run configs/examples/simulated_tracks.json
ARG DEBIAN=12
FROM debian:${DEBIAN}
WORKDIR /evbench
COPY . .
# Built for any processor: the image may run on another one than it was built on.
RUN ./setup.sh --for figures --set EVBENCH_NATIVE=OFF release evbench \
 && cmake --install build/release --prefix /usr/local \
 && rm -rf build /var/lib/apt/lists/*
ENTRYPOINT ["evbench"]
