"""Set-ups of the laboratory: standard tests as scenes, with the specimen's own things left open."""
