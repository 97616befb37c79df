"""The pictures of docs/gallery and docs/images/methods; run by scripts/gallery."""
