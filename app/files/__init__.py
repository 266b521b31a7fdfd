"""Files that users download and upload: pictures, movies, replays, configurations, runs."""
