# `make dist`, then: docker build -t simworlds .
# docker run -i --rm -v simworlds:/data simworlds                      the documentation server, on stdio
# docker run --rm -v simworlds:/data simworlds kb build 5.1            a base for it; or kb fetch 5.1 --from …
FROM python:3.13-slim-bookworm

COPY .ci/debian-packages release/docker/install.sh /tmp/install/
COPY dist/ /tmp/dist/
RUN /tmp/install/install.sh /tmp/dist && rm -rf /tmp/install /tmp/dist \
  && useradd --create-home --uid 10001 simworlds && install -d -o simworlds -g simworlds /data

USER simworlds
ENV SIMWORLDS_HOME=/data
VOLUME /data
ENTRYPOINT ["simworlds"]
CMD ["serve"]
