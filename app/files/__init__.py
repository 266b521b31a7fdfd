"""What users take home and bring along: pictures, films, replays, uploads."""
